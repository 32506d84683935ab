//! Clients in Python.
