"""The ledger of the tests' kernels: what each becomes, so that two trees of the package can be compared.

    python -m tests.ledger collect STORE [pytest's arguments]       what the tests ask the compiler for
    python -m tests.ledger replay STORE [--output FILE] [--against FILE] [--sample N]

`collect` runs the tests and adds each kernel with its argument types and what was asked of it to one file, which
depends neither on the tests nor on where the package keeps its modules. `replay` asks the package on the path for all
of it and writes one line for each request: the hashes of the structured text and of both levels of the derivative
under both engines, or the code of the refusal. Against the ledger of another tree it prints what moved.
"""
