/* The two embedded fonts (TrueType files in memory). */
#ifndef STIC_FONT_DATA_H
#define STIC_FONT_DATA_H

extern const unsigned char stic_font_sans[10704];
extern const unsigned char stic_font_sans_bold[9188];

#endif
