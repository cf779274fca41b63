//! From a formula to an effect of the catalogue: the Rust file that says the same.

use super::tree::{Node, tree};
use super::written::Acts;
use super::{Formula, Function, Op, OverAlpha, Step, Variable};
use crate::effects::User;
use crate::effects::law::LEAST;
use crate::error::{Error, Result};
use crate::motion::Motion;
use crate::param::{Kind, Param, Usual};
use crate::prelude::*;
use crate::random::Noise;

/// Words of Rust, and names that the file has already: no parameter is called so.
const TAKEN: [&str; 51] = [
    "as", "async", "await", "break", "const", "continue", "crate", "dyn", "else", "enum", "extern", "false",
    "fn", "for", "if", "impl", "in", "let", "loop", "match", "mod", "move", "mut", "pub", "ref", "return",
    "self", "static", "struct", "super", "trait", "true", "type", "unsafe", "use", "where", "while",
    "abstract", "become", "box", "do", "final", "gen", "macro", "override", "priv", "try", "typeof",
    "unsized", "virtual", "yield",
];
/// Motions in which the file's own test holds it to the formula.
const MOTIONS: usize = 6;

/// The file, with marks for what differs from law to law; other marks stand in what these stand for.
const FILE: &str = include_str!("effect.txt");
const TOUCHES: &str = "    const TOUCHES: &'static [Channel] = &[$these];\n";
const STARTS: &str = "
    /// Parts of what the motion goes through.
    fn starts(survey: &Survey) -> Vec<[f64; $count]> {
        let starts = formula::starts(&Self::PARAMS, survey).into_iter();
        starts.filter_map(|values| values.try_into().ok()).collect()
    }
";
const DRIVE: &str = "    #[inline(always)]
    fn load<T: Scalar>($takes, motion: &Motion<T>) -> Load<T> {
$lines        Load::drive($answer)
    }
}
";
const SCALE: &str = "    #[inline(always)]
    fn load<T: Scalar>($takes, motion: &Motion<T>) -> Load<T> {
$lines        Load::friction_scale(($answer).max(T::of($least)))
    }
}
";
const RUB: &str = "    #[inline(always)]
    fn load<T: Scalar>($takes, $given: &Motion<T>) -> Load<T> {
$lines        Load { mu: $answer, position_share: T::of(1.0), inertia_share: T::of(1.0), ..Load::none() }
    }
}
";
const BY_LOAD: &str = "    const MAKES_NONLINEAR: Option<Nonlinear> = Some(Nonlinear::ByLoad);\n";
const SENSE: &str = "    #[inline(always)]
    fn sense<T: Scalar>($takes, motion: &Motion<T>, tau: T) -> T {
$lines        tau + $answer
    }
}
";
const STRAIGHT: &str = "    /// What is in proportion to the acceleration is an inertia.
    #[inline(always)]
    fn load<T: Scalar>(p: &[T; $count], motion: &Motion<T>) -> Load<T> {
        let drive = Self::torque(p, &Motion { alpha: T::of(0.0), ..*motion });
        let inertia = Self::torque(p, &Motion { alpha: T::of(1.0), ..*motion }) - drive;
        Load { drive, inertia, ..Load::none() }
    }
}

impl $Name {
    #[inline(always)]
    fn torque<T: Scalar>($takes, motion: &Motion<T>) -> T {
$lines        $answer
    }
}
";
const STORED: &str = "{
                let load = $Name::load(&$values, &motion);
                load.drive + load.inertia * alpha
            }";

/// The source of an effect.
#[derive(Debug, Clone)]
pub struct Source {
    /// The file.
    pub text: String,
    /// Its line in the registry, and the list there that it belongs to.
    pub line: String,
    /// `loads` or `sensors`.
    pub list: &'static str,
}

/// Writes an effect that is stated as a formula as the effect `id` of the catalogue; its test has parameter values `p`.
///
/// # Errors
/// Names what has no formula, or one that asks for memory.
pub fn source(user: &User, id: &str, p: &[f64]) -> Result<Source> {
    let bad = |why: &str| Err(Error::invalid(format!("effect '{}'", user.info.id), why));
    let Some(law) = user.formula() else {
        return bad("is a function; only a formula can be written in Rust");
    };
    if law.remembers() {
        return bad("depends on s, and so on where the knob has been; write it by hand, as presliding.rs is");
    }
    let (acts, count) = (Acts::of(user.info), law.params().len().to_string());
    let name: String = id.split('_').map(capital).collect();
    let params = user.info.params;
    let searched = params.iter().any(|param| param.kind == Kind::Nonlinear);
    let straight = acts == Acts::Load && law.over_alpha() == OverAlpha::Straight;
    let (lines, answer) = written(law, &names(law.params()));
    // Friction per load may be the same in every motion.
    let moves = [&lines, &answer].into_iter().any(|text| text.contains("motion."));
    let calls = searched || [&lines, &answer].into_iter().any(|text| text.contains("formula::"));
    let (kind, list) =
        if acts == Acts::Sensor { ("SensorEffect", "sensors") } else { ("LoadEffect", "loads") };
    let mut imports = vec!["Effect", kind, "Words"];
    imports.extend(searched.then_some("Survey"));
    imports.extend(calls.then_some("formula"));
    imports.extend(law.rubs().then_some("Nonlinear"));
    imports.sort_unstable();
    let (touches, does, asked) = match acts {
        Acts::Sensor => (None, SENSE, "$Name::sense(&$values, &motion, 0.0)"),
        Acts::Friction => {
            (Some("Channel::FrictionScale"), SCALE, "$Name::load(&$values, &motion).friction_scale")
        }
        Acts::Load if law.rubs() => (
            Some("Channel::Mu, Channel::PositionShare, Channel::InertiaShare"),
            RUB,
            "motion.direction() * $Name::load(&$values, &motion).mu",
        ),
        Acts::Load if straight => (Some("Channel::Drive, Channel::Inertia"), STRAIGHT, STORED),
        Acts::Load => (Some("Channel::Drive"), DRIVE, "$Name::load(&$values, &motion).drive"),
    };
    let cases = cases(law, acts, p).into_iter().map(|([t, theta, omega, alpha], answer)| {
        format!("            ([{t:?}, {theta:?}, {omega:?}, {alpha:?}], {answer:?}),\n")
    });
    // What a part holds may name others after it.
    let parts = [
        ("$does", does.to_owned()),
        ("$asked", asked.to_owned()),
        ("$touches", touches.map_or_else(String::new, |these| TOUCHES.replace("$these", these))),
        ("$given", if moves { "motion" } else { "_" }.to_owned()),
        ("$bends", if law.rubs() { BY_LOAD } else { "" }.to_owned()),
        ("$starts", if searched { STARTS } else { "" }.to_owned()),
        ("$motion", if acts == Acts::Sensor { "Motion" } else { "{Channel, Load, Motion}" }.to_owned()),
        ("$roles", if params.iter().any(held) { ", Usual" } else { "" }.to_owned()),
        ("$imports", imports.join(", ")),
        ("$takes", format!("&[{}]: &[T; $count]", names(law.params()).join(", "))),
        ("$lines", lines),
        ("$answer", answer),
        ("$least", format!("{LEAST:?}")),
        ("$params", params.iter().map(row).collect()),
        ("$cases", cases.collect()),
        ("$values", format!("{p:?}")),
        ("$count", count.clone()),
        ("$kind", kind.to_owned()),
        ("$Name", name.clone()),
        ("$id", id.to_owned()),
        ("$law", law.text().to_owned()),
    ];
    let text = parts.into_iter().fold(FILE.to_owned(), |text, (mark, part)| text.replace(mark, &part));
    Ok(Source { text, line: format!("{id}::{name}({count}),"), list })
}

fn capital(word: &str) -> String {
    let mut characters = word.chars();
    characters.next().map_or_else(String::new, |first| first.to_uppercase().chain(characters).collect())
}

/// Names of parameters as Rust has them: in small letters, none of them twice.
fn names(params: &[String]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for param in params {
        let mut name = param.to_lowercase();
        while TAKEN.contains(&name.as_str())
            || name == "motion"
            || name == "tau"
            || name == "_"
            || names.contains(&name)
        {
            name.push('_');
        }
        names.push(name);
    }
    names
}

fn held(param: &Param) -> bool {
    param.usual == Usual::Fixed
}

/// A parameter as its row.
fn row(param: &Param) -> String {
    let [torque, angle, time] = param.unit.powers();
    let unit = if param.unit.powers() == [0; 3] {
        "Unit::NUMBER".into()
    } else {
        format!("Unit::of({torque}, {angle}, {time})")
    };
    let bound = |x: f64| match x {
        f64::INFINITY => "f64::INFINITY".to_owned(),
        f64::NEG_INFINITY => "f64::NEG_INFINITY".to_owned(),
        x => format!("{x:?}"),
    };
    let (name, meaning) = (param.name, param.meaning);
    match param.kind {
        Kind::Linear => format!("        Param::linear({name:?}, {unit}, {meaning:?}),\n"),
        _ => {
            let (lower, upper, neutral) = (bound(param.lower), bound(param.upper), param.neutral);
            let usual = if held(param) { ".usually(Usual::Fixed)" } else { "" };
            format!(
                "        Param::shape({name:?}, {unit}, [{lower}, {upper}], {neutral:?}, {meaning:?}){usual},\n"
            )
        }
    }
}

/// Motions, and what the formula answers in them where it has a value.
fn cases(law: &Formula, acts: Acts, p: &[f64]) -> Vec<([f64; 4], f64)> {
    let mut noise = Noise::new(1);
    let mut any = |size: f64| (1e3 * size * noise.normal()).round() / 1e3;
    let mut found = Vec::new();
    for _ in 0..100 * MOTIONS {
        let motion = [any(1.0).abs(), any(2.0), any(4.0), any(30.0)];
        let [t, theta, omega, alpha] = motion;
        let answer: f64 = law.at(p, &Motion::exact(t, theta, omega, alpha));
        let answer = if acts == Acts::Friction { answer.max(LEAST) } else { answer };
        if answer.is_finite() && found.len() < MOTIONS {
            found.push((motion, answer));
        }
    }
    found
}

/// A law in Rust: lines before it, for what it needs twice, and itself.
fn written(law: &Formula, names: &[String]) -> (String, String) {
    // Friction under a load is what there is of it per load, forward.
    let one = |op: Op| law.rubs() && matches!(op, Op::Motion(Variable::Load | Variable::Direction));
    let forward = |step: &Step| Step { op: if one(step.op) { Op::Number(1.0) } else { step.op }, ..*step };
    let nodes = tree(&law.steps.iter().map(forward).collect::<Vec<_>>());
    let mut uses = vec![0; nodes.len()];
    nodes.iter().flat_map(Node::parts).for_each(|part| uses[part] += 1);
    let mut texts: Vec<(String, u8)> = Vec::new();
    let (mut lines, mut kept) = (String::new(), 0);
    for (node, uses) in nodes.iter().zip(uses) {
        let mut text = said(node, &texts, names, &law.splines);
        if uses > 1 && !node.is_leaf() {
            kept += 1;
            lines.push_str(&format!("        let part_{kept} = {};\n", text.0));
            text = (format!("part_{kept}"), ATOM);
        }
        texts.push(text);
    }
    (lines, texts.pop().map_or_else(String::new, |(text, _)| text))
}

/// A factor that says nothing.
const ONE: &str = "T::of(1.0)";
/// How strongly a text holds together: sums, products, what a method may be called of.
const SUM: u8 = 0;
const PRODUCT: u8 = 1;
const SIGNED: u8 = 2;
const ATOM: u8 = 3;

fn said(node: &Node, texts: &[(String, u8)], names: &[String], splines: &[Vec<f64>]) -> (String, u8) {
    let [left, right] = node.of.map(|at| texts.get(at).cloned().unwrap_or_default());
    let within = |(text, holds): &(String, u8), least: u8| {
        if *holds < least { format!("({text})") } else { text.clone() }
    };
    let plain = |(text, _): &(String, u8)| text.clone();
    let called = |name: &str| (format!("formula::{name}({})", plain(&left)), ATOM);
    let method = |name: &str| (format!("{}.{name}", within(&left, ATOM)), ATOM);
    let joined = |sign: &str, own: u8, after: u8| {
        (format!("{} {sign} {}", within(&left, own), within(&right, after)), own)
    };
    match node.op {
        Op::Number(x) => (format!("T::of({x:?})"), ATOM),
        Op::Parameter(at) => (names.get(at).cloned().unwrap_or_default(), ATOM),
        Op::Motion(Variable::Direction) => ("motion.direction()".into(), ATOM),
        Op::Motion(variable) => (format!("motion.{}", variable.name()), ATOM),
        Op::Add => joined("+", SUM, PRODUCT),
        Op::Subtract => joined("-", SUM, PRODUCT),
        Op::Multiply if left.0 == ONE => right,
        Op::Multiply if right.0 == ONE => left,
        Op::Multiply => joined("*", PRODUCT, SIGNED),
        Op::Divide => joined("/", PRODUCT, SIGNED),
        Op::Negate => (format!("-{}", within(&left, ATOM)), SIGNED),
        Op::Raise(2.0) if left.1 == ATOM && !left.0.contains('(') => (format!("{0} * {0}", left.0), PRODUCT),
        Op::Raise(exponent) => (format!("formula::raised({}, {exponent:?})", plain(&left)), ATOM),
        Op::Power => (format!("formula::power({}, {})", plain(&left), plain(&right)), ATOM),
        Op::Call(Function::Sin) => method("sin_cos().0"),
        Op::Call(Function::Cos) => method("sin_cos().1"),
        Op::Call(Function::Exp) => method("exp()"),
        Op::Call(Function::Abs) => method("abs()"),
        Op::Call(Function::Sqrt) => (format!("formula::raised({}, 0.5)", plain(&left)), ATOM),
        Op::Call(Function::Min) => method(&format!("min({})", plain(&right))),
        Op::Call(Function::Max) => method(&format!("max({})", plain(&right))),
        Op::Call(function) => called(function.name()),
        Op::Spline(at) => {
            let high = splines.get(at).map(Vec::as_slice).unwrap_or_default();
            (format!("formula::spline(&{high:?}, {})", plain(&left)), ATOM)
        }
    }
}
