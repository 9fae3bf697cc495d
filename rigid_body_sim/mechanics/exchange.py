"""What commands, strikes and effects have exchanged with a body: one small vector, summed in the ledger."""

# layout: work done on the body (J), energy turned into heat (J), angular impulse about the point of reference (world axes, N m s)
WORK, DISSIPATED = 0, 1
ANGULAR_IMPULSE = slice(2, 5)
EXCHANGE_SIZE = 5
