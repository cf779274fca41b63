"""The workbench: the loop of `learn` by hand and eye, in a browser on this machine."""
