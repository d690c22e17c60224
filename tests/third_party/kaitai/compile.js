// Compiles a Kaitai Struct description:
//
//     NODE_PATH=… node compile.js DESCRIPTION LANGUAGE FOLDER

const { readFileSync, writeFileSync } = require('node:fs');
const { join } = require('node:path');
const compiler = require('kaitai-struct-compiler');
const { parse } = require('yaml');

async function compile(description, language, folder) {
  const files = await compiler.compile(language, parse(readFileSync(description, 'utf8')), null, false);
  for (const [name, text] of Object.entries(files)) writeFileSync(join(folder, name), text);
}

compile(...process.argv.slice(2)).catch((error) => {
  console.error(String(error));
  process.exit(1);
});
