//! Tests of the engine: elements, loops, events, steps, backends, derivatives.

mod adaptive;
mod allocation;
mod backends;
mod bad_patches;
mod blocks;
mod bouncing_ball;
mod brake;
mod common;
mod coupled_loops;
mod delay;
mod edits;
mod elements;
mod known_problems;
mod laws;
mod limit;
mod loop_fuzz;
mod loops;
mod macros;
mod order;
mod problems;
mod relay;
mod reset;
mod scipy;
mod sensitivity;
mod step_length;
mod within_step;
