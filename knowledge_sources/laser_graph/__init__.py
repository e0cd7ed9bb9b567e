"""A consistent map from laser scans: scan matching, loop closures, a graph of poses."""
