"""knobcam: a haptic camera. Measure a knob, fit its physics, learn which effect is missing."""
