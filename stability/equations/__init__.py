"""From the linearised equations of a layer to the matrices of A(k) - rate B(k)."""
