//! Integration tests of the equations: derived, stated and compared.

mod compare;
