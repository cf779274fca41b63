"""The rig: its port, its wire log, its calibration, and an emulated one for those who have none."""
