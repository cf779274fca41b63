"""What every layer stands on: files written whole, strict JSON, tables, and how a result shows itself."""
