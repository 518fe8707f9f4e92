"""Damaged archives: flipped bits are found by `info --verify`.

Needs TREBSWEEP (the program) and MPIEXEC in the environment.
"""

import random
import re
import unittest
import zlib

import numpy as np

from archives import h5py
from support import DirectoryTest

FIELDS = ("speed", "status", "steps")
JOB = f"[lattice]\nincrement = 0.04\n[solver]\ntolerance = 1e-8\n[output]\nfields = {', '.join(FIELDS)}\n"
SWEEP = ("sweep", "job.cfg", "--progress", "none", "--output.file")


class DamageTest(DirectoryTest):
    """Damages copies of plain0.h5 and its compressed version, plain1.h5."""

    JOB_TEXT = JOB
    SCENE = ""  # of the first tile, in a report

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.write("job.cfg", cls.JOB_TEXT)
        for compression in (0, 1):
            cls().run_program(*SWEEP, f"plain{compression}.h5", "--output.compression", str(compression), ranks=2)

    def setUp(self):
        self.random = random.Random(1)

    def flip(self, name, map_name, tile):
        """Flips a random bit of a tile's values in a map, in the file."""
        with h5py.File(self.path(name)) as archive:
            data = archive[map_name]
            # Only tiles with designs have chunks. They are numbered in the order of their cells.
            chunk = sorted((data.id.get_chunk_info(i) for i in range(data.id.get_num_chunks())),
                           key=lambda chunk: chunk.chunk_offset)[tile]
            raw = data.id.read_direct_chunk(chunk.chunk_offset)[1]
            kind, compressed, edge = data.dtype, data.compression, data.chunks
            count = np.minimum(edge, np.array(data.shape) - chunk.chunk_offset)

        def values(stored):
            """The tile's values as bytes, shuffled if compressed; None if they cannot be decompressed."""
            try:
                whole = zlib.decompress(stored) if compressed else stored
            except zlib.error:
                return None
            # Shuffled: the first bytes of all values, then the second bytes, ...
            planes = np.frombuffer(whole, "u1").reshape((kind.itemsize, *edge) if compressed else
                                                        (*edge, kind.itemsize))
            inside = tuple(slice(n) for n in count)
            return planes[(slice(None), *inside) if compressed else inside].tobytes()

        # The padding of a chunk beyond the lattice, and a few bits of compressed data, change no value.
        flipped = bytearray(raw)
        while values(flipped) == values(raw):
            flipped = bytearray(raw)
            flipped[self.random.randrange(len(raw))] ^= 1 << self.random.randrange(8)
        with open(self.path(name), "r+b") as file:
            file.seek(chunk.byte_offset)
            file.write(flipped)

    def tiles(self, name):
        with h5py.File(self.path(name)) as archive:
            return len(archive["tile_block"])

    def verify(self, name):
        """The damage that `info --verify` reports: {(map, tile)}."""
        done = self.run_program("info", name, "--verify", code=None)
        damage = {(found[1], int(found[2]))
                  for found in re.finditer(r"^damaged +(\w+), tile (\d+): .*r1 = ", done.stdout, re.MULTILINE)}
        self.assertEqual(done.returncode, 1 if damage else 0, done.stdout + done.stderr)
        self.assertEqual("verified" in done.stdout, not damage)
        self.assertEqual(done.stderr.count("\n"), 1 if damage else 0)
        return damage


class Flips(DamageTest):
    def find_flips(self, compression):
        name = f"plain{compression}.h5"
        whole = self.read(name)
        self.assertEqual(self.verify(name), set())
        parts = [(field, tile) for field in FIELDS for tile in range(self.tiles(name))]
        for _ in range(10):
            damage = self.random.sample(parts, 10)
            for part in damage:
                self.flip(name, *part)
            self.assertEqual(self.verify(name), set(damage))
            self.write(name, whole)

    def test_each_of_100_flipped_bits_is_found_in_its_map_and_tile(self):
        self.find_flips(0)

    def test_each_of_100_flipped_bits_of_a_compressed_archive_is_found_in_its_map_and_tile(self):
        self.find_flips(1)

    def test_the_report_names_the_part_of_the_lattice(self):
        whole = self.read("plain0.h5")
        with h5py.File(self.path("plain0.h5"), "r+") as archive:
            axes = [archive[name][...] for name in ("r1", "r3", "r2")]
            scene, *block = archive["tile_block"][0].tolist()
            first, edge = block[:3], block[3:]
            self.assertEqual(scene, 0)
            inside = (0,) * (archive["speed"].ndim - 3) + tuple(slice(i, i + n) for i, n in zip(first, edge))
            archive["speed"][inside] += 1e-9
        done = self.run_program("info", "plain0.h5", "--verify", code=1)
        ranges = ", ".join(f"{name} = {axis[start]} to {axis[start + count - 1]}"
                           for name, axis, start, count in zip(("r1", "r3", "r2"), axes, first, edge))
        self.assertIn(f"speed, tile 0: {self.SCENE}{ranges} m\n", done.stdout)
        self.assertIn("repeat the command of the sweep with --overwrite", done.stderr)
        self.write("plain0.h5", whole)


if __name__ == "__main__":
    unittest.main()
