//! From a law to what works it out: one number that each act changes, and a few that are kept beside it.

use super::tree::{Node, tree};
use super::{Function, Op, Step, Variable};
use crate::prelude::*;

/// Numbers that are kept at a time: those that are needed twice, as far as there is room, and below them what an
/// operation waits for. Of an operation the part that needs more of them comes first, so that those of the longest law
/// suffice (Sethi & Ullman 1970): as many as the number of its leaves can be halved.
pub(super) const KEPT: usize = 16;
/// The first place of those that are needed twice.
const SHARED: usize = 8;

/// Where an act finds the other number that it needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Source {
    Number(f64),
    Parameter(u8),
    Motion(Variable),
    Kept(u8),
}

/// What is done with the number that was worked out last.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Act {
    Take(Source),
    Keep(u8),
    Add(Source),
    Subtract(Source),
    From(Source),
    Multiply(Source),
    Divide(Source),
    Into(Source),
    Least(Source),
    Most(Source),
    Negate,
    Square,
    Raise(f64),
    ToThe(Source),
    Exponent(Source),
    Call(Function),
    Spline(u8),
}

/// The acts of a law, in the order in which they are done.
pub(super) fn program(steps: &[Step]) -> Vec<Act> {
    let nodes = tree(steps);
    let mut uses = vec![0_usize; nodes.len()];
    nodes.iter().flat_map(Node::parts).for_each(|part| uses[part] += 1);
    let mut needs = vec![0_usize; nodes.len()];
    for at in 0..nodes.len() {
        let Node { op, of: [left, right] } = nodes[at];
        needs[at] = match op.takes() {
            2 => {
                let waits = needs[left] == needs[right] && !nodes[left].is_leaf() && !nodes[right].is_leaf();
                needs[left].max(needs[right]) + usize::from(waits)
            }
            1 => needs[left],
            _ => 0,
        };
    }
    let mut writer = Writer { nodes: &nodes, uses, needs, shared: Vec::new(), acts: Vec::new() };
    writer.write(nodes.len().saturating_sub(1), 0);
    writer.acts
}

struct Writer<'a> {
    nodes: &'a [Node],
    uses: Vec<usize>,
    /// How many places its parts take while it is worked out.
    needs: Vec<usize>,
    /// Nodes that are kept for good, from [`SHARED`] on.
    shared: Vec<usize>,
    acts: Vec<Act>,
}

impl Writer<'_> {
    /// Where a number is found without working it out.
    fn found(&self, at: usize) -> Option<Source> {
        match self.nodes[at].op {
            Op::Number(x) => Some(Source::Number(x)),
            Op::Parameter(place) => Some(Source::Parameter(place as u8)),
            Op::Motion(variable) => Some(Source::Motion(variable)),
            _ => {
                let place = self.shared.iter().position(|kept| *kept == at)?;
                Some(Source::Kept((SHARED + place) as u8))
            }
        }
    }

    /// Makes a node the number that was worked out last, without the places below `free`.
    fn write(&mut self, at: usize, free: usize) {
        if let Some(source) = self.found(at) {
            self.acts.push(Act::Take(source));
            return;
        }
        let Some(Node { op, of: [left, right] }) = self.nodes.get(at).copied() else { return };
        let act = if op.takes() == 2 {
            // Of two that have to be worked out the one that needs more goes first.
            let (last, other) = match (self.found(left), self.found(right)) {
                (_, Some(_)) => (left, right),
                (Some(_), _) => (right, left),
                _ if self.needs[right] > self.needs[left] => (left, right),
                _ => (right, left),
            };
            let source = self.beside(other, free);
            self.write(last, free + usize::from(self.found(other).is_none()));
            both(op, source, last == left)
        } else {
            self.write(left, free);
            match op {
                Op::Negate => Act::Negate,
                Op::Raise(2.0) => Act::Square,
                Op::Raise(exponent) => Act::Raise(exponent),
                Op::Call(function) => Act::Call(function),
                Op::Spline(place) => Act::Spline(place as u8),
                _ => return,
            }
        };
        self.acts.push(act);
        if self.uses[at] > 1 && self.shared.len() < KEPT - SHARED {
            self.acts.push(Act::Keep((SHARED + self.shared.len()) as u8));
            self.shared.push(at);
        }
    }

    /// Works a number out that an operation needs beside the last one, and keeps it.
    fn beside(&mut self, at: usize, free: usize) -> Source {
        if let Some(source) = self.found(at) {
            return source;
        }
        self.write(at, free);
        if let Some(source) = self.found(at) {
            return source;
        }
        self.acts.push(Act::Keep(free as u8));
        Source::Kept(free as u8)
    }
}

/// An operation of the last number, its left side or its right one, and another.
fn both(op: Op, other: Source, left: bool) -> Act {
    match (op, left) {
        (Op::Add, _) => Act::Add(other),
        (Op::Multiply, _) => Act::Multiply(other),
        (Op::Subtract, true) => Act::Subtract(other),
        (Op::Subtract, false) => Act::From(other),
        (Op::Divide, true) => Act::Divide(other),
        (Op::Divide, false) => Act::Into(other),
        (Op::Call(Function::Min), _) => Act::Least(other),
        (Op::Call(_), _) => Act::Most(other),
        (_, true) => Act::ToThe(other),
        (_, false) => Act::Exponent(other),
    }
}
