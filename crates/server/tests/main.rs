//! Integration tests of the server: who may use it, what it serves, and its limits.

mod client;
mod comparisons;
mod limits;
mod pages;
mod sessions;
