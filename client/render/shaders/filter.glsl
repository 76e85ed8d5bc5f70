// What the texture's texels give: premultiplied linear light. `level`: of those that were used.
vec4 texels_filtered(Footprint footprint, out float level) {
#if FILTER == NEAREST || FILTER == BILINEAR
    int nearest = nearest_level(footprint);
    level = float(nearest);
#if FILTER == BILINEAR
    return sample_level(nearest, footprint.centre);
#else
    Place place;
    bool found = find_place(nearest, footprint.centre, place);
    return found ? nearest_at(place) : nothing_yet();
#endif
#elif FILTER == ANISOTROPIC
    return anisotropic(footprint, level);
#elif FILTER == DRIVER_ANISOTROPIC
    return driver_anisotropic(footprint, level);
#elif FILTER == LINE_INTEGRAL
    return line_integral(footprint, level);
#elif FILTER == SUPERSAMPLE
    return supersampled(footprint, level);
#else
    Level between = level_of(footprint.longer_squared);
    level = number_of(between);
    return trilinear(footprint.centre, between);
#endif
}

// What a pixel shows: the texture, and what hands hold over it
vec4 filtered(Footprint footprint, out float level) {
    vec4 colour = texels_filtered(footprint, level);
#ifdef HELD_SPRITES
    colour = with_held_sprites(colour, footprint);
#endif
    return colour;
}
