use super::*;

#[test]
fn a_picture_has_its_colours_and_its_text() {
    let drawing = |text: &str| {
        format!(
            "<svg width=\"40\" height=\"20\" viewBox=\"0 0 40 20\" xmlns=\"http://www.w3.org/2000/svg\"><rect \
             width=\"20\" height=\"20\" fill=\"#0072b2\"/><text x=\"22\" y=\"15\" font-family=\"sans-serif\" \
             font-size=\"14\">{text}</text></svg>"
        )
    };
    let [with, without] = ["W", ""].map(|text| png(&drawing(text)).expect("fonts are installed"));
    let [with, without] = [with, without].map(|picture| Pixmap::decode_png(&picture).expect("a PNG"));
    assert_eq!((with.width(), with.height()), (120, 60));
    let color = with.pixel(30, 30).expect("inside").demultiply();
    assert_eq!((color.red(), color.green(), color.blue()), (0x00, 0x72, 0xb2));
    let inked = |picture: &Pixmap| picture.pixels().iter().filter(|pixel| pixel.alpha() > 128).count();
    assert!(inked(&with) > inked(&without) + 50, "{} {}", inked(&with), inked(&without));
    assert!(png("<svg").is_err());
}

/// The page has the size of the picture, 40 × 20 px of 0.75 pt, and text is text.
#[test]
fn a_pdf_is_one_page_of_the_pictures_size() {
    let drawing = "<svg width=\"40\" height=\"20\" viewBox=\"0 0 40 20\" xmlns=\"http://www.w3.org/2000/svg\"><text x=\"2\" \
                   y=\"15\" font-family=\"sans-serif\" font-size=\"14\">W</text></svg>";
    let content = pdf(drawing).expect("fonts are installed");
    let text = String::from_utf8_lossy(&content);
    assert!(text.starts_with("%PDF-1."), "{}", &text[..20]);
    assert!(text.contains("/MediaBox [0 0 30 15]"), "{text}");
    assert_eq!(text.matches("/Type /Page\n").count(), 1, "{text}");
    assert!(text.contains("/FontFile"), "{text}");
    assert!(pdf("<svg").is_err());
}
