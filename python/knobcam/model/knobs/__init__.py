"""The five knobs of the haptic-camera paper (Table 7), as model files."""
