//! Shapes as fields, and what can be made of them: the toolbox of Payne & Toga 1992 and Sanchez et al. 2015.

pub mod language;
