//! Tests of the `.lfslab` container against its specification.

mod assemble;
mod atomic;
mod damage;
mod round_trip;
mod rules;
mod specification;
