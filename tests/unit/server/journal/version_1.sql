-- A journal as the program wrote it when edits had no step, with its lay-out, its three edits and their checksums.
PRAGMA auto_vacuum=INCREMENTAL;
PRAGMA journal_mode=WAL;
BEGIN IMMEDIATE;
CREATE TABLE journal (
    only      INTEGER PRIMARY KEY CHECK (only = 1),
    lineage   BLOB NOT NULL,
    scene     TEXT NOT NULL,
    forgotten INTEGER NOT NULL   -- edits up to this revision are gone
) STRICT;
CREATE TABLE edit (
    revision INTEGER PRIMARY KEY,
    id       BLOB NOT NULL UNIQUE,
    accepted INTEGER NOT NULL,   -- milliseconds since 1970
    bytes    BLOB NOT NULL,
    checksum INTEGER NOT NULL    -- XXH3 of all that stands before it; see checksum_of()
) STRICT;
PRAGMA application_id=1953722986;
PRAGMA user_version=1;
INSERT INTO journal VALUES (1, X'00112233445566778899aabbccddeeff', 'garden', 0);
INSERT INTO edit VALUES (1, X'101112131415161718191a1b1c1d1e1f', 1760000000000, X'7468652066697273742065646974', 8421048402313035652);
INSERT INTO edit VALUES (2, X'202122232425262728292a2b2c2d2e2f', 1760000001000, X'0a04616e6e611202', 2240375130182916697);
INSERT INTO edit VALUES (3, X'303132333435363738393a3b3c3d3e3f', 1760000002000, X'', -299556153845512338);
COMMIT;
