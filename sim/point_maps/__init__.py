"""Maps made of points, as others wrote them."""
