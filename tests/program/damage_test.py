"""Damaged archives: flipped bits are found by `info --verify` and repaired by a resumed sweep.

Needs TREBSWEEP (the program) and MPIEXEC in the environment.
"""

import math
import os
import random
import re
import struct
import unittest
import zlib

import numpy as np

from archives import differences, h5py
from support import DirectoryTest

FIELDS = ("speed", "status", "steps")
JOB = f"[lattice]\nincrement = 0.04\n[solver]\ntolerance = 1e-8\n[output]\nfields = {', '.join(FIELDS)}\n"
SWEEP = ("sweep", "job.cfg", "--progress", "none", "--output.file")


class DamageTest(DirectoryTest):
    """Damages copies of plain0.h5 and its compressed version, plain1.h5."""

    JOB_TEXT = JOB

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
            return len(archive["tile_done"])

    def verify(self, name):
        """The damage that `info --verify` reports: {(map, tile)}."""
        done = self.run_program("info", name, "--verify", code=None)
        damage = {(found[1], int(found[2]))
                  for found in re.finditer(r"^damaged +(\w+), tile (\d+): .*r1 = ", done.stdout, re.MULTILINE)}
        self.assertEqual(done.returncode, 1 if damage else 0, done.stdout + done.stderr)
        self.assertEqual("verified" in done.stdout, not damage)
        self.assertEqual(done.stderr.count("\n"), 1 if damage else 0)
        return damage

    def repair(self, compression, ranks):
        """Resumes the sweep, whose archive must then be that of the uninterrupted one. Returns the tiles that the sweep
        says are damaged."""
        done = self.run_program(*SWEEP, "job.h5", "--output.compression", str(compression), ranks=ranks)
        self.assertEqual(differences(self.path("job.h5"), self.path(f"plain{compression}.h5")), [])
        with h5py.File(self.path("job.h5")) as archive:
            self.assertTrue(0 < archive.attrs["lane_utilisation"] <= 1)
        self.assertEqual(self.verify("job.h5"), set())
        os.remove(self.path("job.h5"))
        found = re.search(r"^warning: of the \d+ tiles done, these are damaged and will be computed again: (.*)$",
                          done.stderr, re.MULTILINE)
        return found and found[1]


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
            edge = [int(archive["tile_done"].attrs[f"edge_{name}"]) for name in ("r1", "r3", "r2")]
            archive["speed"][0, 0, 0] += 1e-9
        done = self.run_program("info", "plain0.h5", "--verify", code=1)
        ranges = ", ".join(f"{name} = {axis[0]} to {axis[count - 1]}"
                           for name, axis, count in zip(("r1", "r3", "r2"), axes, edge))
        self.assertIn(f"speed, tile 0: {ranges} m\n", done.stdout)
        self.assertIn("rename it to plain0.h5.partial", done.stderr)
        self.write("plain0.h5", whole)

    def test_damage_of_tallies_and_checksums_is_found(self):
        whole = self.read("plain0.h5")
        with h5py.File(self.path("plain0.h5"), "r+") as archive:
            archive["tile_tally"][2, 8] += 1
            archive["tile_checksum"][4, 1] ^= np.uint64(1)
        self.assertEqual(self.verify("plain0.h5"), {("tile_tally", 2), ("status", 4)})
        self.write("plain0.h5", whole)


class Repairs(DamageTest):
    def make_partial(self, compression):
        """Makes job.h5.partial, in which the tiles with the smallest r1 are done; returns their number."""
        self.write("job.h5.partial", self.read(f"plain{compression}.h5"))
        with h5py.File(self.path("job.h5.partial"), "r+") as partial:
            edge = int(partial["tile_done"].attrs["edge_r1"])
            done = len(partial["tile_done"]) // math.ceil(len(partial["r1"]) / edge)
            for name in ("tile_done", "tile_tally", "tile_checksum"):
                partial[name][done:] = 0
            partial["speed"][edge:] = np.nan
        return done

    def test_a_flipped_bit_in_any_tile_done_is_found_and_its_tile_is_computed_again(self):
        for compression in (0, 1):
            for tile in range(self.make_partial(compression)):
                self.make_partial(compression)
                field = self.random.choice(FIELDS)
                self.flip("job.h5.partial", field, tile)
                self.assertEqual(self.verify("job.h5.partial"), {(field, tile)})
                self.assertEqual(self.repair(compression, ranks=(1, 2, 3)[tile % 3]), str(tile))

    def test_an_intact_partial_archive_is_continued_without_a_warning(self):
        self.make_partial(0)
        self.assertIsNone(self.repair(0, ranks=2))

    def test_a_complete_archive_with_a_partial_name_is_repaired(self):
        for compression in (0, 1):
            last = self.tiles("plain0.h5") - 1  # smaller than its chunk
            self.write("job.h5.partial", self.read(f"plain{compression}.h5"))
            for tile in (2, 3, last):
                self.flip("job.h5.partial", "speed", tile)
            self.assertEqual(self.repair(compression, ranks=2), f"2 to 3, {last}")

    def flip_in_index(self, tile, bit):
        """Writes job.h5.partial: plain0.h5 with a bit flipped in the index of status, in a tile's entry."""
        with h5py.File(self.path("plain0.h5")) as archive:
            status = archive["status"]
            chunks = sorted(status.id.get_chunk_info(i).chunk_offset for i in range(status.id.get_num_chunks()))
            # An entry: size, filters, offset, 0, address.
            entry = struct.pack("<II4Q", math.prod(status.chunks), 0, *chunks[tile], 0)
        damaged = bytearray(self.read("plain0.h5"))
        self.assertEqual(damaged.count(entry), 1)
        damaged[damaged.index(entry) + bit // 8] ^= 1 << bit % 8
        self.write("job.h5.partial", bytes(damaged))
        self.assertIn(("status", tile), self.verify("job.h5.partial"))

    def bit_that_moves_a_tile_over_another(self, tile):
        """A bit of the address of a tile's status whose change moves it over another tile's."""
        with h5py.File(self.path("plain0.h5")) as archive:
            status = archive["status"].id
            chunks = [status.get_chunk_info(i) for i in range(status.get_num_chunks())]
        chunks.sort(key=lambda chunk: chunk.chunk_offset)
        own, others = chunks[tile], chunks[:tile] + chunks[tile + 1:]
        return next(bit for bit in range(64) for other in others
                    if abs((own.byte_offset ^ 1 << bit) - other.byte_offset) < own.size)

    def test_a_partial_archive_whose_index_lacks_a_tile_is_refused(self):
        for byte in (24, 32):  # in the offset along r2; in what must be 0
            self.flip_in_index(1, 8 * byte + 7)
            damaged = self.read("job.h5.partial")
            done = self.run_program(*SWEEP, "job.h5", ranks=2, code=1)
            self.assertIn("damaged: the index of map status lacks tile 1", done.stderr)
            self.assertEqual(self.read("job.h5.partial"), damaged)
        os.remove(self.path("job.h5.partial"))

    def test_a_tile_written_over_others_is_found_before_the_archive_gets_its_final_name(self):
        self.flip_in_index(1, 8 * 40 + self.bit_that_moves_a_tile_over_another(1))
        done = self.run_program(*SWEEP, "job.h5", ranks=2, code=1)
        self.assertIn("these are not as they were written: ", done.stderr)
        self.assertFalse(os.path.exists(self.path("job.h5")))
        os.remove(self.path("job.h5.partial"))

    def test_tiles_with_damaged_tallies_are_computed_again(self):
        cases = (("released", -1, "released in a tally is -1"), ("released", np.nan, "released in a tally is nan"),
                 ("best_cell", 1e14, "outside the lattice"))
        self.assertEqual(self.make_partial(0), len(cases))
        with h5py.File(self.path("plain0.h5")) as plain:
            columns = plain["tile_tally"].attrs["columns"].split()
        for tile, (column, value, message) in enumerate(cases):
            self.make_partial(0)
            with h5py.File(self.path("job.h5.partial"), "r+") as partial:
                partial["tile_tally"][tile, columns.index(column)] = value
            self.assertIn(message, self.run_program("info", "job.h5.partial", code=1).stderr)
            self.assertEqual(self.verify("job.h5.partial"), {("tile_tally", tile)})
        with h5py.File(self.path("job.h5.partial"), "r+") as partial:
            partial["tile_tally"][0, columns.index("best_value")] = 1e9  # possible, but wrong
            partial["tile_tally"][1, columns.index("released")] = -1
        self.assertEqual(self.repair(0, ranks=2), "0 to 2")


if __name__ == "__main__":
    unittest.main()
