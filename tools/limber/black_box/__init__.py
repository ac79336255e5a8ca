"""Black boxes, and what is made of them."""
