//! A law: a term of the grammar, or the sum of several.

use super::grammar::{Factor, Motions, Term};

/// A law as it is written, with its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Written {
    /// The formula.
    pub text: String,
    /// Names and values of its parameters.
    pub params: Vec<(String, f64)>,
}

/// Terms that are added.
#[derive(Debug, Clone, PartialEq)]
pub struct Sum(pub Vec<Term>);

impl From<Term> for Sum {
    fn from(term: Term) -> Self {
        Self(vec![term])
    }
}

impl Sum {
    /// Its term, if it has no other.
    pub fn alone(&self) -> Option<&Term> {
        if let [term] = &self.0[..] { Some(term) } else { None }
    }

    /// Parameters of all terms.
    pub fn count(&self) -> usize {
        self.0.iter().map(Term::count).sum()
    }

    /// How long it is.
    pub fn complexity(&self) -> usize {
        self.0.iter().map(Term::complexity).sum()
    }

    /// What it is a law of, by name.
    pub fn variables(&self) -> Vec<&'static str> {
        let mut names: Vec<&'static str> = self.0.iter().flat_map(Term::variables).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// The functions of all terms.
    pub fn factors(&self) -> impl Iterator<Item = &Factor> {
        self.0.iter().flat_map(|term| &term.factors)
    }

    /// The linear columns of one term after the other.
    pub fn columns(&self, motions: &Motions) -> Vec<Vec<f64>> {
        self.0.iter().flat_map(|term| term.columns(motions)).collect()
    }

    /// As it is written, with the coefficients of its columns.
    pub fn written(&self, coefficients: &[f64]) -> Written {
        let (mut params, mut rest) = (Vec::new(), coefficients);
        let text = |term: &Term| {
            let (own, others) = rest.split_at(rest.len().min(1 + usize::from(term.sine().is_some())));
            rest = others;
            term.written(own, &mut params)
        };
        let texts: Vec<String> = self.0.iter().map(text).collect();
        Written { text: texts.join(" + "), params }
    }
}
