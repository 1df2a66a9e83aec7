/* FEBio decks of format version 2.5: their tree in the words of version 4.0. See feb.h.
 *
 *     2.5                                             4.0
 *     <Geometry>                                      <Mesh>
 *     <Step><Control/></Step>                         <Step><step><Control/></step></Step>
 *     <fix bc="x,y" node_set="a"/>                    <bc type="zero displacement" ...>  <dofs>
 *     <prescribe bc="x" node_set="a"><scale lc="1">   <bc type="prescribed displacement" ...> <dof>
 *     <nodal_load bc="x" node_set="a"><scale lc="1">  <nodal_load type="nodal_load" ...>  <dof>
 *     <init bc="vx" node_set="a">                     <ic type="init_dof" ...>  <dof>
 *     <velocity node_set="a">                         <ic type="velocity" node_set="a">
 *     <loadcurve id="1" type="smooth"><point>         <load_controller ...><points><pt>
 *
 * A curve that a condition names (lc) becomes that of its size. What is not among these stays as it
 * is, and the readers say what they say of it. New elements have the line of those that they are
 * made of.
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

/* Calls what is `old` in the deck `name` of this type, and says its attribute `from` as a child
 * `to` instead. */
static bool rename_as(xmlNode *node, const char *old, const char *name, const char *type,
                      const char *from, const char *to) {
    xmlChar *value = xmlGetProp(node, chars(from)), *own = xmlGetProp(node, chars("type"));
    bool good =
        (!own || strcmp(from, "type") == 0 || xmlSetProp(node, chars(LAR_FEB_OLD_TYPE), own)) &&
        xmlSetProp(node, chars("type"), chars(type)) &&
        (!value || add_child(node, to, (const char *)value));
    xmlFree(value);
    xmlFree(own);
    xmlNodeSetName(node, chars(name));
    node->_private = (void *)(uintptr_t)old; /* lar_feb_name */
    return good;
}

/* The curve of a condition is that of its size. */
static bool pass_curve(lar_feb *feb, xmlNode *node) {
    const char *curve = lar_feb_attribute(feb, node, "lc");
    for (xmlNode *size = lar_feb_first(node); size && curve; size = lar_feb_next(size)) {
        if (!lar_feb_is_any(size, "scale value pressure traction")) continue;
        if (lar_feb_attribute(feb, size, "lc")) return true; /* refused: there are two */
        return xmlSetProp(size, chars("lc"), chars(curve)) && xmlUnsetProp(node, chars("lc")) == 0;
    }
    return true;
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
    return rename_as(curve, "loadcurve", "load_controller", "loadcurve", "type", "interpolate") &&
           (!extend || add_child(curve, "extend", extend));
}

/* One condition, or what has them. */
static bool renew(lar_feb *feb, xmlNode *node) {
    static const char *const names[][5] = {
        {"fix", "bc", "zero displacement", "bc", "dofs"},
        {"prescribe", "bc", "prescribed displacement", "bc", "dof"},
        {"nodal_load", "nodal_load", "nodal_load", "bc", "dof"},
        {"init", "ic", "init_dof", "bc", "dof"},
        {"velocity", "ic", "velocity", "bc", "dof"},
    };
    if (!pass_curve(feb, node)) return false;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *const *n = names[i];
        if (lar_feb_is(node, n[0]) && (i != 3 || lar_feb_attribute(feb, node, "bc")))
            return rename_as(node, n[0], n[1], n[2], n[3], n[4]);
    }
    return lar_feb_is(node, "loadcurve") ? renew_curve(feb, node) : true;
}

static bool renew_sections(lar_feb *feb, xmlNode *parent) {
    bool good = true;
    for (xmlNode *section = lar_feb_first(parent); section && good;
         section = lar_feb_next(section)) {
        bool holds = lar_feb_is_any(section, "Boundary Loads Initial LoadData");
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
