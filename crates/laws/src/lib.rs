//! Nothing but tests: what holds of every effect, however a knob is driven.
