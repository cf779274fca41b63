//! Answers that are kept: what was computed against what a file of the repository says. Shared by the tests of the crates,
//! each of which keeps its own files.

use std::env;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// The environment variable with which the files are made anew.
const KEEP: &str = "KNOBCAM_KEEP";
/// Instruction sets, mathematical libraries and the last digit differ by less, relative to a number and to the largest
/// of its line.
const APART: [f64; 2] = [2e-6, 1e-8];
/// What stands before a chance, or a gain in variances of the noise: they are kept to this many of their own roots.
const ABOUT: char = '~';
/// See [`ABOUT`].
const NEAR: f64 = 0.05;

/// What one test answers, a line each: what it is, a colon, numbers or words.
pub struct Answers {
    path: PathBuf,
    lines: Vec<(String, String)>,
}

impl Answers {
    pub fn of(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/kept/answers");
        Self { path: folder.join(name).with_extension("txt"), lines: Vec::new() }
    }

    pub fn numbers(&mut self, what: impl Into<String>, values: impl IntoIterator<Item = f64>) {
        let values = values.into_iter();
        let text = values.map(|x| if x == x.trunc() { format!("{x}") } else { format!("{x:.6e}") });
        self.lines.push((what.into(), text.collect::<Vec<_>>().join(" ")));
    }

    pub fn words(&mut self, what: impl Into<String>, text: impl AsRef<str>) {
        self.lines.push((what.into(), text.as_ref().to_owned()));
    }

    /// A chance or a gain, which are the less sure the greater they are.
    pub fn about(&mut self, what: impl Into<String>, value: f64) {
        self.words(what, format!("{ABOUT}{value:.3}"));
    }

    /// A long column by its length, sums that weigh each number differently, and some of its numbers.
    pub fn column(&mut self, what: impl Into<String>, column: &[f64]) {
        let known = || column.iter().enumerate().filter(|(_, x)| x.is_finite());
        let weighed = |w: f64| known().map(|(i, x)| x * (1.5 + (w * i as f64).sin())).sum::<f64>();
        let sums = [known().count() as f64, weighed(0.0), weighed(0.37), weighed(1.9)];
        let some = (0..2).map(|i| column.get((2 * i + 1) * column.len() / 5).copied().unwrap_or(0.0));
        self.numbers(what, sums.into_iter().chain(some));
    }

    /// Compares all with the file, or makes it anew and prints what changed.
    pub fn done(self) {
        let kept = fs::read_to_string(&self.path).unwrap_or_default();
        let name = self.path.display();
        let before: Vec<(&str, &str)> = kept.lines().filter_map(|line| line.split_once(": ")).collect();
        let mut changes = String::new();
        for at in 0..before.len().max(self.lines.len()) {
            let (was, is) = (before.get(at), self.lines.get(at));
            let same = |was: &(&str, &str), is: &(String, String)| was.0 == is.0 && alike(was.1, &is.1);
            if was.zip(is).is_none_or(|(was, is)| !same(was, is)) {
                let was = was.map_or(String::new(), |(what, text)| format!("{what}: {text}"));
                let is = is.map_or(String::new(), |(what, text)| format!("{what}: {text}"));
                let _ = writeln!(changes, "- {was}\n+ {is}");
            }
        }
        if env::var_os(KEEP).is_some() {
            let text: String = self.lines.iter().map(|(what, text)| format!("{what}: {text}\n")).collect();
            fs::write(&self.path, text).unwrap();
            println!("{name}\n{changes}");
            return;
        }
        assert!(
            changes.is_empty(),
            "other answers than are kept in {name}; where they should be, make them anew with \
             `{KEEP}=1 cargo test --package {} kept:: -- --nocapture`:\n{changes}",
            env!("CARGO_PKG_NAME")
        );
    }
}

/// Whether two lines say the same: their words exactly, their numbers nearly.
fn alike(was: &str, is: &str) -> bool {
    let (was, is): (Vec<&str>, Vec<&str>) = (was.split(' ').collect(), is.split(' ').collect());
    let number = |word: &&str| word.parse::<f64>().ok();
    let scale = was.iter().filter_map(number).filter(|x| x.is_finite()).fold(0.0, |a: f64, x| a.max(x.abs()));
    let near = |was: &str, is: &str| {
        let pair = was.strip_prefix(ABOUT).zip(is.strip_prefix(ABOUT));
        pair.and_then(|(was, is)| number(&was).zip(number(&is)))
            .is_some_and(|(a, b)| (a - b).abs() <= NEAR * a.abs().sqrt())
    };
    let same = |(was, is): (&&str, &&str)| {
        was == is
            || near(was, is)
            || number(was)
                .zip(number(is))
                .is_some_and(|(a, b)| (a - b).abs() <= APART[0] * a.abs().min(b.abs()) + APART[1] * scale)
    };
    was.len() == is.len() && was.iter().zip(&is).all(same)
}
