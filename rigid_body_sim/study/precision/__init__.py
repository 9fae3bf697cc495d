"""What accuracy costs in time: error against CPU time of every method, and of peers, measured against high-precision references."""
