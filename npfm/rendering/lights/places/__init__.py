"""The places that the generated lights show, one module a place."""
