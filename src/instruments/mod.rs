//! Instruments: what can be read from a trace.
