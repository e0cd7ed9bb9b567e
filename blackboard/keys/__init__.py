"""Who may do what on a board that other machines can reach: certificates, roles, and what was rejected."""
