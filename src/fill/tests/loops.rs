//! Loops alone: their measures, and triangulations of all lengths.

use super::*;
