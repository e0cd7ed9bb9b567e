"""Knowledge sources: each turns what stands on the board into knowledge of a higher level."""
