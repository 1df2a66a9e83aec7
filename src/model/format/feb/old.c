/* FEBio decks of format version 2.5: their tree in the words of version 4.0. See feb.h.
 *
 *     2.5                                             4.0
 *     <Geometry>                                      <Mesh>
 *     <Step><Control/></Step>                         <Step><step><Control/></step></Step>
 *     <fix bc="x,y" node_set="a"/>                    <bc type="zero displacement" ...>  <dofs>
 *     <prescribe bc="x" node_set="a"><scale lc="1">   <bc type="prescribed displacement" ...> <dof>
 *     <nodal_load bc="x" node_set="a"><scale lc="1">  <nodal_load type="nodal_load" ...>  <dof>
 *     <loadcurve id="1" type="smooth"><point>         <load_controller ...><points><pt>
 *
 * What is not among these stays as it is, and the readers say what they say of it. New elements
 * have the line of those that they are made of.
 */
#include "model/format/feb/feb.h"

#include <string.h>

static const xmlChar *chars(const char *text) {
    return (const xmlChar *)text;
}

/* A new child with a text, or without (NULL). NULL: out of memory. */
static xmlNode *add_child(xmlNode *parent, const char *name, const char *text) {
    xmlNode *child = xmlNewTextChild(parent, NULL, chars(name), chars(text));
    if (child) child->line = parent->line;
    return child;
}

/* Calls it `name` of this type, and says its attribute `from` as a child `to` instead. */
static bool rename_as(xmlNode *node, const char *name, const char *type, const char *from,
                      const char *to) {
    xmlChar *value = xmlGetProp(node, chars(from));
    bool good = xmlSetProp(node, chars("type"), chars(type)) &&
                (!value || add_child(node, to, (const char *)value));
    xmlFree(value);
    xmlNodeSetName(node, chars(name));
    return good;
}

static bool renew_curve(lar_feb *feb, xmlNode *curve) {
    const char *extend = lar_feb_attribute(feb, curve, "extend");
    xmlNode *points = xmlNewNode(NULL, chars("points"));
    if (!points) return false;
    points->line = curve->line;
    for (xmlNode *point = lar_feb_first(curve), *next; point; point = next) {
        next = lar_feb_next(point);
        if (lar_feb_is(point, "loadpoint")) xmlNodeSetName(point, chars("pt"));
        xmlUnlinkNode(point);
        xmlAddChild(points, point);
    }
    xmlAddChild(curve, points);
    return rename_as(curve, "load_controller", "loadcurve", "type", "interpolate") &&
           (!extend || add_child(curve, "extend", extend));
}

/* One condition, or what has them. */
static bool renew(lar_feb *feb, xmlNode *node) {
    if (lar_feb_is(node, "fix")) return rename_as(node, "bc", "zero displacement", "bc", "dofs");
    if (lar_feb_is(node, "prescribe"))
        return rename_as(node, "bc", "prescribed displacement", "bc", "dof");
    if (lar_feb_is(node, "nodal_load"))
        return rename_as(node, "nodal_load", "nodal_load", "bc", "dof");
    return lar_feb_is(node, "loadcurve") ? renew_curve(feb, node) : true;
}

static bool renew_sections(lar_feb *feb, xmlNode *parent) {
    bool good = true;
    for (xmlNode *section = lar_feb_first(parent); section && good;
         section = lar_feb_next(section)) {
        bool holds = lar_feb_is(section, "Boundary") || lar_feb_is(section, "Loads") ||
                     lar_feb_is(section, "LoadData");
        if (lar_feb_is(section, "Geometry")) xmlNodeSetName(section, chars("Mesh"));
        if (lar_feb_is(section, "Step")) {
            good = renew_sections(feb, section);
            xmlNode *step = good ? xmlNewNode(NULL, chars("Step")) : NULL;
            if (!step) return false;
            step->line = section->line;
            xmlNodeSetName(section, chars("step"));
            xmlReplaceNode(section, step);
            xmlAddChild(step, section);
            section = step;
        }
        for (xmlNode *node = holds ? lar_feb_first(section) : NULL; node && good;
             node = lar_feb_next(node))
            good = renew(feb, node);
    }
    return good;
}

lar_status lar_feb_renew(lar_feb *feb) {
    return renew_sections(feb, feb->root) ? LAR_OK : lar_feb_no_memory(feb, "the deck");
}
