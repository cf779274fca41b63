//! The step never asks for memory.
#![allow(unsafe_code, reason = "a counting allocator is unsafe to declare; it counts and hands on")]

use knobcore::effects::{Id, Place};
use knobcore::model::Model;
use knobcore::param::Axis;
use knobcore::render::{Limits, Renderer, Sensed};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

struct Counting;

static ASKED: AtomicU64 = AtomicU64::new(0);

unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ASKED.fetch_add(1, Ordering::SeqCst);
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        unsafe { System.dealloc(at, layout) }
    }
    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ASKED.fetch_add(1, Ordering::SeqCst);
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
    let open = Limits { torque: 1.0, torque_rate: 1e4, speed: 1000.0 };
    for model in &mut models {
        for (name, value) in [("inertia.M", 1e-4), ("coulomb.neg", 0.02), ("coulomb.pos", 0.03)] {
            model.set(name, value).unwrap();
        }
        let mut knob = Renderer::new(model, 5000.0, None, open).unwrap();
        let mut torque = [0.0; 100];
        let before = ASKED.load(Ordering::SeqCst);
        for i in 0..1_000_000 {
            let t = f64::from(i) * 2e-4;
            let (sin, cos) = (3.0 * t).sin_cos();
            let hand = (i % 3 == 0).then_some(0.01 * cos);
            torque[i as usize % 100] =
                knob.step(Sensed { theta: sin, omega: 3.0 * cos, alpha: -9.0 * sin, hand });
        }
        assert_eq!(ASKED.load(Ordering::SeqCst) - before, 0);
        assert!(knob.fault().is_none() && torque.iter().any(|tau| *tau != 0.0));
    }
}
