"""What tests are made with: how a derivative is measured, under which engines, with what random inputs; programs that
look through the compiler, as `python -m tests.harness.bulk`; the pictures of docstrings, the documents, the rooms."""
