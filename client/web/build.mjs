// Bundles the page: node build.mjs NODE_MODULES OUT STREAM_DESCRIPTION. OUT then holds all that the server serves at `/`.
// STREAM_DESCRIPTION is what protoc --include_imports --descriptor_set_out makes of proto/stream.proto.
import {copyFile, mkdir, readFile, readdir, writeFile} from 'node:fs/promises';
import {createRequire} from 'node:module';
import path from 'node:path';
import {fileURLToPath} from 'node:url';

const here = path.dirname(fileURLToPath(import.meta.url));
const [modules, out, stream_description] = process.argv.slice(2).map((folder) => path.resolve(folder));
const {build} = createRequire(path.join(modules, 'index.js'))('esbuild');

const {metafile} = await build({
  entryPoints: {app: path.join(here, 'src/main.js')},
  nodePaths: [modules],
  alias: {'stream-description': stream_description},
  loader: {[path.extname(stream_description)]: 'binary'},
  bundle: true,
  minify: true,
  format: 'esm',
  target: ['chrome111', 'firefox114', 'safari16.4'],
  legalComments: 'none', // licences.txt holds them, whole
  metafile: true,
  outdir: out,
  logLevel: 'warning',
});

await mkdir(out, {recursive: true});
for (const file of await readdir(path.join(here, 'static'))) {
  await copyFile(path.join(here, 'static', file), path.join(out, file));
}
await writeFile(path.join(out, 'licences.txt'), await licences(Object.keys(metafile.inputs)));

/** The licence of every package that went into the bundle. */
async function licences(inputs) {
  const names = inputs.map((file) => file.match(/node_modules\/((?:@[^/]+\/)?[^/]+)/)?.[1]);
  const texts = [];
  for (const name of [...new Set(names)].filter(Boolean).sort()) {
    const {version, license} = JSON.parse(await readFile(path.join(modules, name, 'package.json'), 'utf8'));
    texts.push(`${name} ${version} (${license})\n\n${await readFile(await licence_file(name), 'utf8')}`);
  }
  return `This page is built with the following packages.\n\n${texts.join(`\n\n${'-'.repeat(80)}\n\n`)}`;
}

/** In the package's own folder; of one that comes without, in licences/. @param {string} name */
async function licence_file(name) {
  const folder = path.join(modules, name);
  const file = (await readdir(folder)).find((entry) => /^licen[cs]e/i.test(entry));
  if (file) return path.join(folder, file);
  const ours = `${name.replace('/', '_')}.txt`;
  if ((await readdir(path.join(here, 'licences'))).includes(ours)) return path.join(here, 'licences', ours);
  throw new Error(`${name} is bundled, but its folder holds no licence, and neither does licences/`);
}
