//! From signs on the lattice to a closed surface: the dual of the cuberille (Bærentzen §5).
