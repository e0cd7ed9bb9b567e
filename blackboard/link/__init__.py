"""The board across processes and machines: what goes over zenoh, and how."""
