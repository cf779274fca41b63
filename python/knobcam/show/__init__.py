"""Showing: pictures, linked plots, tables and reports of results, which know nothing of them."""
