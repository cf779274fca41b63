//! Neither the step nor the loop around it asks for memory.
#![allow(unsafe_code, reason = "a counting allocator is unsafe to declare; it counts and hands on")]

use knobcore::effects::{Id, Place};
use knobcore::error::{Error, Result};
use knobcore::model::Model;
use knobcore::model_file;
use knobcore::param::Axis;
use knobrender::{Limits, Renderer, Sensed};
use knobrig::realtime::{Controller, Loop, Plan, Plant, Ticks, VirtualClock};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;

struct Counting;

thread_local! {
    /// How often this thread, that is one test, asked.
    static ASKED: Cell<u64> = const { Cell::new(0) };
}

unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ASKED.set(ASKED.get() + 1);
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        unsafe { System.dealloc(at, layout) }
    }
    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ASKED.set(ASKED.get() + 1);
        unsafe { System.realloc(at, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn a_million_steps_of_every_load_and_of_every_joint_ask_for_no_memory() {
    let loads = |id: &&Id| id.info().place == Place::Load;
    let mut models =
        vec![Model::new(&Id::BUILT_IN.iter().filter(loads).copied().collect::<Vec<_>>(), Axis::Rotary)];
    for id in Id::BUILT_IN.iter().filter(|id| id.info().place == Place::Coupling) {
        models.push(Model::equation_1(Axis::Rotary, true).with(*id).unwrap());
    }
    let stated = "[effects.brake]\nlaw = \"2 a (omega/w) / (1 + (omega/w)^2)\"\na = 1e-3\nw = 3.0\n\
                  [effects.grip]\nlaw = \"1 + r exp(-s/b)\"\nacts = \"friction\"\nr = 0.5\nb = 0.1\n";
    for joint in ["", "[effects.compliance]\nk = 5.0\nd = 1e-3\nshare = 0.5\n"] {
        let base = "schema = \"knobcam.model/1\"\n[effects.inertia]\nM = 1e-4\n[effects.coulomb]\nneg = 0.02\n\
                    pos = 0.03\n";
        models.push(model_file::parse(&format!("{base}{joint}{stated}")).unwrap());
    }
    let open = Limits { torque: 1.0, torque_rate: 1e4, speed: 1000.0 };
    for model in &mut models {
        for (name, value) in [("inertia.M", 1e-4), ("coulomb.neg", 0.02), ("coulomb.pos", 0.03)] {
            model.set(name, value).unwrap();
        }
        let mut knob = Renderer::new(model, 5000.0, None, open).unwrap();
        let mut torque = [0.0; 100];
        let before = ASKED.get();
        for i in 0..1_000_000 {
            let t = f64::from(i) * 2e-4;
            let (sin, cos) = (3.0 * t).sin_cos();
            let hand = (i % 3 == 0).then_some(0.01 * cos);
            torque[i as usize % 100] =
                knob.step(Sensed { theta: sin, omega: 3.0 * cos, alpha: -9.0 * sin, hand });
        }
        assert_eq!(ASKED.get() - before, 0);
        assert!(knob.fault().is_none() && torque.iter().any(|tau| *tau != 0.0));
    }
}

struct Still;

impl Plant for Still {
    fn read(&mut self) -> Result<Sensed> {
        Ok(Sensed { theta: 0.1, omega: 0.0, alpha: 0.0, hand: Some(0.01) })
    }

    fn write(&mut self, _: f64) -> Result<()> {
        Ok(())
    }
}

struct Spring;

impl Controller for Spring {
    fn step(&mut self, sensed: Sensed) -> f64 {
        0.01 * sensed.theta
    }

    fn fault(&self) -> Option<Error> {
        None
    }
}

/// How often a loop asked that is made, run and reported, and its steps; late wake-ups make it miss periods too.
fn asked_by_a_loop(seconds: f64) -> (u64, u64) {
    let plan = Plan { seconds: Some(seconds), missed_share: 1.0, ..Plan::default() };
    let mut wakes = 0_u64;
    let late = || {
        wakes += 1;
        if wakes.is_multiple_of(100) { 300_000 } else { 5_000 }
    };
    let before = ASKED.get();
    let clock = VirtualClock::late(Ticks::default(), late);
    let report = Loop::new(plan, Arc::default()).unwrap().run(Spring, Still, clock);
    (ASKED.get() - before, report.tally.steps)
}

#[test]
fn a_loop_over_a_million_periods_asks_for_no_more_memory_than_one_over_two_seconds() {
    let (short, few) = asked_by_a_loop(2.0);
    let (long, many) = asked_by_a_loop(210.0);
    assert!(few > 9_000 && many > 1_000_000, "{few} and {many} steps");
    assert_eq!(long, short);
}
