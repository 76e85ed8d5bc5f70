import OlMap from 'ol/Map.js';
import View from 'ol/View.js';
import {defaults as default_interactions} from 'ol/interaction/defaults.js';

import {level_range} from './level_rail.js';
import {texel_projection} from './page_layer.js';

/**
 * A map over a texture: a unit is a texel of level 0, y grows upwards from −side to 0, and nothing turns.
 * @param {import('./texture.js').Texture} texture @param {any[]} layers
 */
export function make_map(texture, layers) {
  const {finest, coarsest} = level_range(texture);
  const side = texture.side_texels;
  return new OlMap({
    controls: [],
    interactions: default_interactions({altShiftDragRotate: false, pinchRotate: false, keyboard: false}),
    layers,
    view: new View({
      projection: texel_projection(texture),
      center: [side / 2, -side / 2],
      resolution: 1,
      minResolution: 2 ** finest,
      maxResolution: 2 ** coarsest,
      extent: [0, -side, side, 0],
      constrainOnlyCenter: true,
      smoothExtentConstraint: false,
      smoothResolutionConstraint: false,
      enableRotation: false,
    }),
  });
}
