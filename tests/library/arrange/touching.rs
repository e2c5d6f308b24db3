//! Solids that touch and nearly touch.
