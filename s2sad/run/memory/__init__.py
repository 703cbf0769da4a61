"""memory: what a generated function will allocate, from its text and its arguments, before it runs."""
from s2sad.run.memory.byte_counts import byte_text
from s2sad.run.memory.call_memory import GrowingTape, LoopRuns, Memory, growing_tapes, loop_runs, memory_of
from s2sad.run.memory.footprint import Footprint, footprint_of
from s2sad.run.memory.returned_shapes import returned_shapes

__all__ = ["Footprint", "GrowingTape", "LoopRuns", "Memory", "byte_text", "footprint_of", "growing_tapes", "loop_runs",
           "memory_of", "returned_shapes"]
