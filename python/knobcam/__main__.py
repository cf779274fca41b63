"""`python -m knobcam` is the `knobcam` command."""

from __future__ import annotations

from .cli import main

raise SystemExit(main())
