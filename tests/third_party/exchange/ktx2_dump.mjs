// Prints what ktx-parse finds in a KTX2 file, as JSON with the levels in base64:
//
//     NODE_PATH=… node ktx2_dump.mjs FILE

import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { pathToFileURL } from 'node:url';

// `import` does not look into NODE_PATH, `require` does.
const { read } = await import(pathToFileURL(createRequire(import.meta.url).resolve('ktx-parse')));

const container = read(new Uint8Array(readFileSync(process.argv[2])));
const levels = container.levels.map((level) => ({
  data: Buffer.from(level.levelData).toString('base64'),
  uncompressedByteLength: level.uncompressedByteLength,
}));
process.stdout.write(JSON.stringify({ ...container, levels }));
