//! The steps of a law as a tree, in which what is there twice is there once and numbers are worked out.

use super::functions::applied;
use super::{Op, Step};
use crate::prelude::*;

/// A number of a law, and which others it is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Node {
    pub op: Op,
    /// Places of what it is made of, as many as the operation takes.
    pub of: [usize; 2],
}

impl Node {
    /// The nodes that it is made of.
    pub fn parts(&self) -> impl Iterator<Item = usize> + '_ {
        self.of.iter().take(self.op.takes()).copied()
    }

    /// Whether it is made of no other.
    pub fn is_leaf(&self) -> bool {
        self.op.takes() == 0
    }
}

/// The nodes of a law, each after those that it is made of; the last is the law.
pub(super) fn tree(steps: &[Step]) -> Vec<Node> {
    let mut nodes: Vec<Node> = Vec::new();
    let mut stack: Vec<usize> = Vec::new();
    for step in steps {
        let mut of = [0; 2];
        for part in of.iter_mut().take(step.op.takes()).rev() {
            *part = stack.pop().unwrap_or_default();
        }
        let number = |at: usize| match nodes.get(at).map(|node| node.op) {
            Some(Op::Number(x)) => Some(x),
            _ => None,
        };
        let op = match (step.op.takes(), number(of[0]), number(of[1])) {
            (1, Some(x), _) if !matches!(step.op, Op::Spline(_)) => Op::Number(applied(step.op, x, x)),
            (2, Some(left), Some(right)) => Op::Number(applied(step.op, left, right)),
            _ => step.op,
        };
        let node = Node { op, of: if op.takes() == 0 { [0; 2] } else { of } };
        let place = nodes.iter().position(|known| *known == node).unwrap_or(nodes.len());
        if place == nodes.len() {
            nodes.push(node);
        }
        stack.push(place);
    }
    // Numbers that were worked out leave behind what they were made of.
    kept(&nodes, stack.pop().unwrap_or_default())
}

/// The nodes that one is made of, and itself.
fn kept(nodes: &[Node], root: usize) -> Vec<Node> {
    let mut used = vec![false; nodes.len()];
    if let Some(root) = used.get_mut(root) {
        *root = true;
    }
    for (at, node) in nodes.iter().enumerate().rev() {
        if used[at] {
            node.parts().for_each(|part| used[part] = true);
        }
    }
    let place = |at: usize| used.iter().take(at).filter(|used| **used).count();
    let moved = |node: &Node| Node { of: if node.is_leaf() { [0; 2] } else { node.of.map(place) }, ..*node };
    nodes.iter().zip(&used).filter(|(_, used)| **used).map(|(node, _)| moved(node)).collect()
}
