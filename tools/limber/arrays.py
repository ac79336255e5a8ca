"""Arrays by what is in them."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating]
Integers = NDArray[np.integer]
Flags = NDArray[np.bool_]
Records = NDArray[np.void]  # messages of one type, by field
